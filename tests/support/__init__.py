"""What tests of all folders share: the conversation, its body and its clock."""

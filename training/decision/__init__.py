"""What trains the head that tells orders from everything else that is said."""

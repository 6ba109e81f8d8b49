"""DDS security's files: a keystore as sros2 has it, with permissions that follow from the contract.

`startup` checks a program's enclave before its first node. Nothing here starts a node or needs one.
Imports core and, of ros2, the contract's tables and robot files.
"""

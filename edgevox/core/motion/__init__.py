"""What may move the robot, and what stops it: interlock, software stop, drain, deadlines."""

"""Components that belong to no other package: the disks and the process; and all, as a table."""

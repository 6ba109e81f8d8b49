"""What `edgevox doctor` and the start-up check run in a process of its own."""

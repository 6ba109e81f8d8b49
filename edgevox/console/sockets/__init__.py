"""The WebSockets of the console: what passes on each, and what happens to a slow reader of it."""

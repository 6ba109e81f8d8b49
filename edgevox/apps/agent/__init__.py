"""`edgevox-agent`: built of its parts, started, served."""

"""Files and texts that people write: read within limits, checked, replaced whole."""

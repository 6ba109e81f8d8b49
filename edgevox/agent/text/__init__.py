"""Words as they are written: spelling, names that are the same, reasons."""

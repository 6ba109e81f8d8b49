"""Words as they are written: spelling, numbers, names that are the same, reasons."""

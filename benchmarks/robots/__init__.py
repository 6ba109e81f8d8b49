"""Every body beside its simulator alone."""

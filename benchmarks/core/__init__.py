"""Runs benchmarks, keeps what they find, and renders it: the README, docs/figures.md, plots."""

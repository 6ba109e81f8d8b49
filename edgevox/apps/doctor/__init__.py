"""`edgevox doctor`: looks at the machine, and says what to do.

A check is a probe, which fetches plain values and decides nothing, and a judge, which is pure and
turns them into verdicts. Probes that load foreign libraries run in a process of their own: one that
hangs or dies is a finding, and not the end.
"""

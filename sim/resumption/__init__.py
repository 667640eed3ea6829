"""Going on with a run that was cut short: its state on the disk, and whose state it is."""

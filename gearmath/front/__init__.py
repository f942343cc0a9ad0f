"""What ``import gearmath as gm`` offers: records and verbs of the trade; :mod:`gearmath` loads each on first use."""

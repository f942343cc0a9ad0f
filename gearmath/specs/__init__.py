"""Files that people write: TOML read into frozen models, degrees and inches converted here and nowhere else."""

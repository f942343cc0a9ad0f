"""Sets and members for other programs: STEP, STL of a pair, REXS, plain point files."""

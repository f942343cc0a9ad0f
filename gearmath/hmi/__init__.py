"""The operator's page: what an operator does with set, machine and control, in a browser. docs/operators_page.md."""

"""The pages, each a module with ``build(shared, text)``; their order is in :mod:`gearmath.hmi.shell`."""

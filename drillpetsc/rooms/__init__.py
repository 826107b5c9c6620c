"""Physics components, one a file: each offers fields, blocks, prescribed components and energies (drillpetsc.field)."""

"""Pictures of a run folder: `drillpetsc.plotting.view.view` (the string in its hole) and
`drillpetsc.plotting.plot.plot` (histories, orbits, forces along depth).

They read the files of a run and nothing else. matplotlib and pyvista are imported when a picture is made, not
before.
"""

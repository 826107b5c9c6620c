"""Pictures of a run folder: `drillpetsc.plotting.view.view` (the string in its hole) and
`drillpetsc.plotting.plot.plot` (histories, orbits, forces along depth).

Plotting reads only the files of a run. matplotlib and pyvista are imported when a picture is made.
"""

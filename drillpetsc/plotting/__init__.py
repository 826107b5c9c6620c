"""Pictures of a run folder: `drillpetsc.plotting.run.view.view` (the string in its hole) and
`drillpetsc.plotting.run.plot.plot` (histories, orbits, forces along depth).

Plotting reads only the files of a run. matplotlib and pyvista are imported when a picture is made.
"""

"""Case of the parallel matrix with sensors in pipe and in a rigid item, in mud."""

CASE = """
string:
  - {kind: pipe, name: upper, length: 2 m, od: 127 mm, id: 108.6 mm, element_length: 0.5 m}
  - {kind: body, name: sub, length: 0.3 m, mass: 40 kg, od: 150 mm}
  - {kind: pipe, name: lower, length: 1 m, od: 127 mm, id: 108.6 mm, element_length: 0.5 m}
top: {kind: top_drive, rotation: {time: [0 s, 0.2 s], value: [120 rpm, 60 rpm]}}
initial: {from: statics, inclination: 90 deg}
fluid:
  density: 1200 kg/m3
  rheology: {model: newtonian, viscosity: 1 mPa s}
  flow_rate: {ramp: 0.2 s, value: 5 l/s}
  annulus: false
loads: [{at: 3 m, force: [0, 0, 50 N], value_over: {time: [0 s, 0.1 s, 0.1 s, 1 s], value: [0, 0, 1, 1]}}]
time: {end: 0.3 s}
output:
  checkpoint_every: 0.1 s
  sensors:
    - name: filtered
      at: 1.3 m
      rate: 400 Hz
      radius: 50 mm
      filter: {cutoff: 50 Hz, order: 4}
      channels: [ax, ay, az, rpm, torque, wob, bending, pressure]
    - {name: in-the-sub, at: sub, rate: 333 Hz, radius: 60 mm}
    - {name: lowest, at: 3.3 m, rate: 100 Hz, channels: [ay, rpm]}
"""
NAMES = ("filtered", "in-the-sub", "lowest")

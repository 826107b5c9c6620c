"""``python -m drillpetsc.kernels`` builds the kernels and says where they are."""

from drillpetsc.kernels import build

print(build())

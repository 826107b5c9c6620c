// Kernels on nodes of the string, for each formulation of the string's element.
//
// A kernel is written on position, slope and spin angle of the nodes, the unknowns of the ANCF element.  Another formulation provides a twin
// that carries these to its own unknowns.  The twins stand beside the kernel, in one source: what else a source holds decides what the
// compiler inlines, and so the last bits of a result.
#pragma once
#include "quaternion/on_quaternion.hpp"

// twins of the kernel `name`, whose first NODES nodes are the string's
#define DP_OTHER_FORMULATIONS(name, Kernel, NODES) DP_ON_QUATERNION(name, Kernel, NODES)

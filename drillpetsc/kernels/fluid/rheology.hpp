// Wall shear stress of a drilling fluid in a pipe or an annulus at a given mean speed.
//
// A law is a flat array of doubles, filled by rheology_pack: it may live in an element's parameter row or behind a context pointer.
// The stress is signed, odd in the speed and has a continuous derivative everywhere, zero flow and transition to turbulence included.
#pragma once
#include <type_traits>

#include "core/ad.hpp"
#include "core/names.hpp"

namespace dp {

enum RheologyEntry {
    RHEO_KIND,         // RheologyKind
    RHEO_LAW,          // FrictionLaw
    RHEO_YIELD,        // yield stress [Pa]
    RHEO_CONSISTENCY,  // consistency K [Pa s^n]; plastic viscosity of a Casson fluid [Pa s]
    RHEO_INDEX,        // flow index n [-]
    RHEO_GAMMA,        // shear rate of the regularisation [1/s], above 0
    RHEO_LOG_K,        // ln K
    RHEO_A,            // turbulent friction factor a / Re^b
    RHEO_B,
    RHEO_LIMIT,        // Reynolds number 3470 - 1370 n where laminar flow ends
    RHEO_F_TURBULENT,  // friction factor a / (limit + 800)^b where turbulent flow begins
    RHEO_SHEAR_PIPE,   // nominal shear rate at the wall = this * speed / hydraulic diameter
    RHEO_SHEAR_SLOT,
    RHEO_YIELD_PIPE,   // yield stress times the explicit law's factor [Pa]
    RHEO_YIELD_SLOT,
    RHEO_TABLE,        // bits of the address of a flow curve of the user, see OwnCurve
    RHEOLOGY_SIZE
};
DP_ENUM(RheologyKind, HERSCHEL_BULKLEY, CASSON, OWN, RHEOLOGY_KINDS)  // Newton, Bingham and power law are Herschel-Bulkley fluids
struct FrictionLaw { DP_ENUM(Kind, BLEND, API, EXACT, LAWS) };

// Flow curve of the user: the number of rows, then the rows of the pipe and those of the slot, by rising speed.
struct OwnCurve { DP_ENUM(Column, LOG_RATE, LOG_STRESS, SLOPE, COLUMNS) };  // ln of 8 w/d [1/s], ln of the wall stress [Pa], slope of the latter by the former

constexpr double API_ROUNDING = 40.0;  // half width in Re of the rounding of the two kinks of the API law

struct WallShear {
    double stress;  // [Pa]
    double slope;   // d(stress)/d(speed) [Pa s/m]
    double by_density;  // d(stress)/d(density) at the same speed [Pa m3/kg]
};
WallShear wall_shear_and_slope(const double* law, double w, double hydraulic_diameter, double alpha, double density);

// w mean speed [m/s]; hydraulic_diameter [m]: bore, or hole minus string diameter; alpha 0 pipe, 1 annulus (slot); density [kg/m3].
template <class T, class R>
inline T wall_shear(const double* law, const T& w, double hydraulic_diameter, double alpha, const R& density) {
    const WallShear r = wall_shear_and_slope(law, val(w), hydraulic_diameter, alpha, val(density));
    if constexpr (std::is_same_v<T, double>) return r.stress;
    else if constexpr (!std::is_same_v<R, double>) return chain(r.stress, r.slope, w, r.by_density, density);
    else return chain(r.stress, r.slope, w);
}

}  // namespace dp

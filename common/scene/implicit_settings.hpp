// Keys of mbd.integrator that only the implicit method generalized_alpha has.
#pragma once

namespace tandem::scene {

inline constexpr const char* implicit_settings[] = {"rho_inf", "formulation", "extrapolate", "tolerance",
                                                    "max_iterations"};

}  // namespace tandem::scene

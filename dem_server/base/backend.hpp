// Which processor runs the particles. Both back ends run the same functors and give the same bits.
#pragma once

#include <string>
#include <string_view>

namespace tandem::dem {

enum class Backend { cpu, cuda };

// Resolves "auto", "cpu" or "cuda"; Error{resource} says why a wanted back end is not to be had.
Backend choose_backend(std::string_view wanted);
std::string device_name(Backend backend);
// Whether this build holds CUDA code, and whether a device answers.
bool cuda_built();
bool cuda_present();

}  // namespace tandem::dem

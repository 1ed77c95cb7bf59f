// The processor that runs the particles. Both back ends run the same functors.
#pragma once

#include <string>
#include <string_view>

namespace tandem::particles {

enum class Backend { cpu, cuda };

// Resolves "auto", "cpu" or "cuda"; Error{resource} says why the requested back end is not available.
Backend choose_backend(std::string_view wanted);
std::string device_name(Backend backend);
// Whether this build contains CUDA code, and whether there is a usable device.
bool cuda_built();
bool cuda_present();
// How many devices there are, 0 without CUDA. This thread uses device `number` modulo that from now on.
unsigned cuda_devices();
void use_cuda_device(unsigned number);

}  // namespace tandem::particles

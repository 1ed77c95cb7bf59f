// The error that a function of the solver leaves with tandem_fail(), for the thread that called the function.
#pragma once

namespace tandem::participant {

// Throws that error where `status` is not TANDEM_OK; `function` is named where the solver gave no reason.
void expect_ok(int status, const char* function);

}  // namespace tandem::participant

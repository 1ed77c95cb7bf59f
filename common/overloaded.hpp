// A function object of several functions, for std::visit.
#pragma once

namespace tandem {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace tandem

// An identifier of the HDF5 library, closed at the end of the scope.
#pragma once

#include <hdf5.h>

#include <utility>

namespace tandem {

class Hdf5Handle {
 public:
  // `fail` is called where the library returned no identifier, and throws.
  template <class Fail>
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t), Fail fail) : id_(id), close_(close) {
    if (id_ < 0) fail();
  }
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  // Closes before the end of the scope; the result shows whether that failed.
  herr_t close_now() { return close_(std::exchange(id_, -1)); }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

}  // namespace tandem

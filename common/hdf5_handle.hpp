// An identifier of the HDF5 library, closed at the end of the scope.
#pragma once

#include <hdf5.h>

namespace tandem {

class Hdf5Handle {
 public:
  // `fail` is called where the library gave no identifier, and throws.
  template <class Fail>
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t), Fail fail) : id_(id), close_(close) {
    if (id_ < 0) fail();
  }
  ~Hdf5Handle() { close_(id_); }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

}  // namespace tandem

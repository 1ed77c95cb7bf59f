#include "protocol/codec.hpp"

#include <algorithm>
#include <cstring>

#include "protocol/violation.hpp"

namespace tandem::protocol {
namespace {

// The parts of a payload are listed once, in `visit` below, for both directions: a Writer appends each part,
// a Reader takes each part. Everything on the wire is a multiple of 8 bytes (arrays are padded with zeros),
// so that records stay aligned.
constexpr std::size_t padding(std::size_t size) {
  return (8 - size % 8) % 8;
}

class Writer {
 public:
  explicit Writer(Bytes& out) : out_(out) { out_.clear(); }

  template <class T>
  void value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 8 == 0);
    append(&value, sizeof value);
  }
  template <class T>
  void word(T small) {  // 32 bits in memory, 8 bytes here
    value(static_cast<std::uint64_t>(small));
  }
  template <class T>
  void array(const T& array) {  // vector or string
    value(std::uint64_t{array.size()});
    append(array.data(), array.size() * sizeof(*array.data()));
    out_.resize(out_.size() + padding(out_.size()));
  }
  // Arrays at the end of a payload that a version added: absent after the last one that is not empty.
  template <class... T>
  void rest(const T&... values) {
    std::size_t number = 0, present = 0;
    ((++number, present = values.empty() ? present : number), ...);
    number = 0;
    ((number++ < present ? array(values) : void()), ...);
  }
  template <class T, class F>
  void list(const T& items, F each) {
    value(std::uint64_t{items.size()});
    for (const auto& item : items) each(item);
  }

 private:
  void append(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    out_.insert(out_.end(), bytes, bytes + size);
  }
  Bytes& out_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> in) : in_(in), size_(in.size()) {}

  template <class T>
  void value(T& value) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 8 == 0);
    take(&value, sizeof value);
  }
  template <class T>
  void word(T& small) {
    std::uint64_t wide = 0;
    value(wide);
    if (wide >> 32 != 0)
      throw ProtocolError(Violation::count_too_large, std::to_string(wide) + " does not fit into 32 bits");
    small = static_cast<T>(wide);
  }
  template <class T>
  void array(T& array) {
    constexpr std::size_t item = sizeof(*array.data());
    const std::size_t n = count(item);
    array.resize(n);
    if (n > 0) take(array.data(), n * item);
    std::uint64_t zeros = 0;
    take(&zeros, padding(n * item));
    if (zeros != 0) throw ProtocolError(Violation::trailing_bytes, "the padding of an array is not zero");
  }
  template <class... T>
  void rest(T&... values) {
    bool empty = false;  // the last one that is there
    const auto read = [&](auto& array_of) {
      array_of.clear();
      if (in_.empty()) return;
      array(array_of);
      empty = array_of.empty();
    };
    (read(values), ...);
    if (empty && in_.empty())
      throw ProtocolError(Violation::trailing_bytes, "a payload of " + std::to_string(size_) +
                                                         " bytes ends with an empty list, which is left out");
  }
  template <class T, class F>
  void list(T& items, F each) {
    items.resize(count(8));  // each item has at least a count
    for (auto& item : items) each(item);
  }
  void done() const {
    if (!in_.empty())
      throw ProtocolError(
          Violation::trailing_bytes,
          std::to_string(in_.size()) + " bytes follow the end of a payload of " + std::to_string(size_));
  }

 private:
  // Refuses a count that exceeds the rest of the payload before anything is allocated.
  std::size_t count(std::size_t item) {
    std::uint64_t n = 0;
    value(n);
    if (n > in_.size() / item)
      throw ProtocolError(Violation::count_too_large,
                          "an array announces " + std::to_string(n) + " items of " + std::to_string(item) +
                              " bytes where " + std::to_string(in_.size()) + " bytes are left");
    return static_cast<std::size_t>(n);
  }
  void take(void* to, std::size_t size) {
    if (size > in_.size())
      throw ProtocolError(Violation::truncated, "the payload of " + std::to_string(size_) + " bytes ends " +
                                                    std::to_string(size - in_.size()) + " bytes too early");
    if (size > 0) std::memcpy(to, in_.data(), size);
    in_ = in_.subspan(size);
  }
  std::span<const std::byte> in_;
  std::size_t size_;
};

// Value is T when reading and const T when writing.
template <class Value, class T>
concept Either = std::is_same_v<std::remove_const_t<Value>, T>;

void visit(auto& io, Either<Hello> auto& v) {
  io.word(v.role);
  io.value(v.layout_hash);
  io.value(v.capabilities);
  io.value(v.pid);
  io.array(v.program);
  io.array(v.host);
}

void visit(auto& io, Either<Failure> auto& v) {
  io.word(v.code);
  io.array(v.what);
  io.array(v.where);
  io.array(v.hint);
}

void visit(auto& io, Either<NamedMesh> auto& v) {
  io.array(v.name);
  io.array(v.mesh.vertices);
  io.array(v.mesh.triangles);
}

void visit(auto& io, Either<NamedText> auto& v) {
  io.array(v.name);
  io.array(v.text);
}

void visit(auto& io, Either<Configuration> auto& v) {
  io.array(v.scene_text);
  io.array(v.origin);
  io.list(v.meshes, [&](auto& mesh) { visit(io, mesh); });
  io.list(v.files, [&](auto& file) { visit(io, file); });
  io.array(v.backend);
  io.word(v.threads);
}

void visit(auto& io, Either<Configured> auto& v) {
  io.array(v.boundary);
  io.array(v.facts);
  io.rest(v.sensors);
}

void visit(auto& io, Either<Window> auto& v) {
  io.value(v);
}

void visit(auto& io, Either<MotionSet> auto& v) {
  io.value(v.window);
  io.array(v.bodies);
}

void visit(auto& io, Either<LoadSet> auto& v) {
  io.value(v.window);
  io.value(v.account);
  io.array(v.bodies);
  io.rest(v.sensors);
}

void visit(auto& io, Either<TangentSet> auto& v) {
  io.value(v.time);
  io.array(v.bodies);
  io.rest(v.responses);
}

void visit(auto& io, Either<ControlSet> auto& v) {
  io.value(v.time);
  io.array(v.values);
}

void visit(auto& io, Either<Checkpoint> auto& v) {
  io.value(v.window);
  io.value(v.time);
  io.array(v.path);
}

void visit(auto& io, Either<Nanoseconds> auto& v) {
  io.value(v);
}

void visit(auto& io, Either<BodiesFrame> auto& v) {
  io.value(v.time);
  io.array(v.bodies);
  io.array(v.joints);
  io.value(v.energy);
  io.rest(v.elements, v.contacts);
}

void visit(auto& io, Either<ParticlesFrame> auto& v) {
  io.value(v.time);
  io.array(v.id);
  io.array(v.position);
  io.array(v.velocity);
  io.array(v.spin);
  io.array(v.radius);
  io.rest(v.contacts, v.walls, v.of_bodies, v.liquid);
}

void visit(auto& io, Either<Report> auto& v) {
  io.array(v.facts);
}

}  // namespace

template <class Payload>
void encode(Bytes& out, const Payload& value) {
  Writer writer(out);
  visit(writer, value);
}

template <class Payload>
void decode(std::span<const std::byte> in, Payload& value) {
  Reader reader(in);
  visit(reader, value);
  reader.done();
}

#define PAYLOAD(type)                        \
  template void encode(Bytes&, const type&); \
  template void decode(std::span<const std::byte>, type&);
PAYLOAD(Hello)
PAYLOAD(Failure)
PAYLOAD(Configuration)
PAYLOAD(Configured)
PAYLOAD(Window)
PAYLOAD(MotionSet)
PAYLOAD(LoadSet)
PAYLOAD(TangentSet)
PAYLOAD(ControlSet)
PAYLOAD(Checkpoint)
PAYLOAD(Nanoseconds)
PAYLOAD(BodiesFrame)
PAYLOAD(ParticlesFrame)
PAYLOAD(Report)
#undef PAYLOAD

std::uint64_t size_of_particles_frame(std::uint64_t spheres, bool with_contacts) {
  const auto array = [spheres](std::uint64_t of_one) {
    const std::uint64_t size = spheres * of_one;
    return sizeof(std::uint64_t) + size + padding(size);
  };
  constexpr std::uint64_t vector = 3 * sizeof(float);
  return sizeof(Nanoseconds) + array(sizeof(std::uint32_t)) + array(3 * sizeof(double)) + 2 * array(vector) +
         array(sizeof(float)) +
         (with_contacts && spheres > 0 ? array(ParticlesFrame::contact_values * sizeof(float)) : 0);
}

void decode_nothing(std::span<const std::byte> in) {
  Reader(in).done();
}

}  // namespace tandem::protocol

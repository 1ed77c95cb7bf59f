#include "coordinator/schemes/archive.hpp"

namespace tandem::launch {

void Archive::operator()(const std::string& name, double& value) {
  if (out_)
    out_->write(name, value);
  else
    in_->read(name, value);
}

void Archive::operator()(const std::string& name, std::uint64_t& value) {
  if (out_)
    out_->write(name, value);
  else
    in_->read(name, value);
}

void Archive::operator()(const std::string& name, std::vector<double>& values) {
  if (out_) return out_->write(name, std::span<const double>(values));
  values.resize(in_->size(name));
  in_->read(name, std::span<double>(values));
}

void Archive::operator()(const std::string& name, Eigen::VectorXd& values) {
  if (out_)
    return out_->write(name, std::span<const double>(values.data(), static_cast<std::size_t>(values.size())));
  values.resize(static_cast<Eigen::Index>(in_->size(name)));
  in_->read(name, std::span<double>(values.data(), static_cast<std::size_t>(values.size())));
}

void Archive::operator()(const std::string& name, std::string& text) {
  if (out_)
    out_->write(name, text);
  else
    text = in_->text(name);
}

void Archive::operator()(const std::string& name, std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  (*this)(name, text);
  lines.clear();
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    expect(end != std::string::npos, name, "its last line has no end");
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

void Archive::operator()(const std::string& name, bool& value) {
  auto byte = static_cast<std::uint8_t>(value);
  (*this)(name, byte);
  expect(byte <= 1, name, "it is neither true nor false");
  value = byte == 1;
}

void Archive::expect(bool sound, const std::string& name, const std::string& problem) const {
  if (in_ && !sound)
    throw Error(ErrorCode::resource, "'" + name + "' is damaged: " + problem, in_->path().string(),
                "continue from another checkpoint");
}

void Archive::bytes(const std::string& name, protocol::Bytes& raw) {
  if (out_) return out_->write(name, std::span<const std::byte>(raw));
  raw.resize(in_->size(name));
  in_->read(name, std::span<std::byte>(raw));
}

void Archive::fail(const std::string& name) const {
  throw Error(ErrorCode::resource, "'" + name + "' has another size than in this program",
              in_ ? in_->path().string() : std::string(), "continue with the program that wrote it");
}

}  // namespace tandem::launch

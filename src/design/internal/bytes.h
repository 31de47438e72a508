#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace zwidth::internal {

/// Numbers and texts as the bytes of this machine, for checkpoints.
class ByteWriter {
 public:
  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void put(const std::string& text) {
    put<std::uint64_t>(text.size());
    bytes_ += text;
  }
  void put(std::span<const double> values) {
    put<std::uint64_t>(values.size());
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads them back in the same order. Throws std::runtime_error where they end too early.
class ByteReader {
 public:
  explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T> T get() {
    T value{};
    take(&value, sizeof value);
    return value;
  }
  std::string text() {
    std::string text(size(1), '\0');
    take(text.data(), text.size());
    return text;
  }
  std::vector<double> doubles() {
    std::vector<double> values(size(sizeof(double)));
    take(values.data(), values.size() * sizeof(double));
    return values;
  }
  bool at_end() const { return place_ == bytes_.size(); }

 private:
  std::size_t size(std::size_t each) {
    const auto count = get<std::uint64_t>();
    if (count > (bytes_.size() - place_) / each) throw std::runtime_error("it ends too early");
    return static_cast<std::size_t>(count);
  }
  void take(void* to, std::size_t count) {
    if (count > bytes_.size() - place_) throw std::runtime_error("it ends too early");
    if (count > 0) std::memcpy(to, bytes_.data() + place_, count);
    place_ += count;
  }

  const std::string& bytes_;
  std::size_t place_ = 0;
};

}  // namespace zwidth::internal

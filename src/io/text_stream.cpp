// Samples written as decimal or hexadecimal text, for byte_source.hpp.

#include "core/text.hpp"
#include "io/byte_source.hpp"
#include "io/parse.hpp"

#include <cstring>
#include <utility>

namespace hyperiso {
namespace {

bool separates(char c) { return is_space(c) || c == ','; }

template <class T>
std::optional<T> sample_from(std::string_view word) {
  auto value = number_from<T>(word);
  // A number too large or too small for f32 still has a nearest f32.
  if constexpr (std::is_same_v<T, float>)
    if (!value)
      if (const auto wide = number_from<double>(word)) value = static_cast<float>(*wide);
  return value;
}

template <class T>
class TextDecoder final : public Decoder {
 public:
  TextDecoder(std::shared_ptr<const void> owner, std::string_view characters, std::string file_name)
      : owner_(std::move(owner)), rest_(characters), file_name_(std::move(file_name)) {}

  // Requests are whole samples: only the skipping of StreamSource could split one, and its steps are even.
  Status decode(std::span<std::byte> out) override {
    for (; out.size() >= sizeof(T); out = out.subspan(sizeof(T))) {
      const std::string_view word = next_word(rest_, separates);
      if (word.empty()) return malformed(text("ends after ", decoded_, " numbers, before the samples do"));
      const auto value = sample_from<T>(word);
      if (!value)
        return malformed(text(in_quotes(word), " is not a number of type ", name_of(sample_type_of<T>())));
      std::memcpy(out.data(), &*value, sizeof(T));
      ++decoded_;
    }
    return {};
  }
  Status expect_end() override {
    if (next_word(rest_, separates).empty()) return {};
    return malformed(text("goes on after the ", decoded_, " samples that the sizes say"));
  }

 private:
  Error malformed(std::string_view what) const {
    return {Code::file_malformed, text(file_name_, ": ", what)};
  }
  std::shared_ptr<const void> owner_;
  std::string_view rest_;
  std::string file_name_;
  std::uint64_t decoded_ = 0;
};

class HexDecoder final : public Decoder {
 public:
  HexDecoder(std::shared_ptr<const InputFile> file, std::uint64_t offset)
      : file_(std::move(file)), rest_(file_->characters().substr(offset)) {}

  Status decode(std::span<std::byte> out) override {
    for (std::byte& byte : out) {
      int value = 0;
      for (int half = 0; half < 2; ++half) {
        skip_space();
        if (rest_.empty()) return malformed("the hexadecimal data end before the samples do");
        const int digit = digit_value(rest_.front());
        if (digit < 0) return malformed(text(in_quotes(rest_.substr(0, 1)), " is not a hexadecimal digit"));
        rest_.remove_prefix(1);
        value = value * 16 + digit;
      }
      byte = static_cast<std::byte>(value);
    }
    return {};
  }
  Status expect_end() override {
    skip_space();
    if (rest_.empty()) return {};
    return malformed("the hexadecimal data hold more samples than the sizes say");
  }

 private:
  static int digit_value(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  }
  void skip_space() {
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
  }
  Error malformed(std::string_view what) const {
    return {Code::file_malformed, text(file_->path().string(), ": ", what)};
  }
  std::shared_ptr<const InputFile> file_;
  std::string_view rest_;
};

} // namespace

std::unique_ptr<Decoder> text_decoder(std::shared_ptr<const void> owner, std::string_view characters,
                                      SampleType type, std::string file_name) {
  return visit_sample_type(type, [&](auto sample) -> std::unique_ptr<Decoder> {
    return std::make_unique<TextDecoder<decltype(sample)>>(std::move(owner), characters,
                                                           std::move(file_name));
  });
}

std::unique_ptr<Decoder> hex_decoder(std::shared_ptr<const InputFile> file, std::uint64_t offset) {
  return std::make_unique<HexDecoder>(std::move(file), offset);
}

} // namespace hyperiso

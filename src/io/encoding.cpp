#include "io/encoding.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <new>
#include <zlib.h>

namespace hyperiso {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are written as they lie in memory");

constexpr std::size_t block_bytes = std::size_t{1} << 18;

// Level 1: on coordinates and connectivity the higher levels take several times as long for a few percent.
constexpr int compression_level = 1;

constexpr char base64_digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

enum : unsigned char { blank = 64, padding, invalid };

// Value of each character.
constexpr auto base64_values = [] {
  std::array<unsigned char, 256> values{};
  values.fill(invalid);
  for (const char c : {' ', '\t', '\r', '\n'}) values[static_cast<unsigned char>(c)] = blank;
  values['='] = padding;
  for (unsigned char i = 0; i < 64; ++i) values[static_cast<unsigned char>(base64_digits[i])] = i;
  return values;
}();

unsigned value_of(char digit) { return base64_values[static_cast<unsigned char>(digit)]; }

void put_three(const unsigned char* bytes, char* digits) {
  digits[0] = base64_digits[bytes[0] >> 2];
  digits[1] = base64_digits[(bytes[0] & 3) << 4 | bytes[1] >> 4];
  digits[2] = base64_digits[(bytes[1] & 15) << 2 | bytes[2] >> 6];
  digits[3] = base64_digits[bytes[2] & 63];
}

std::string base64_of(const std::vector<std::uint64_t>& numbers) {
  std::string text;
  Base64Encoder encoder;
  encoder.append({reinterpret_cast<const unsigned char*>(numbers.data()), numbers.size() * 8}, text);
  encoder.finish(text);
  return text;
}

} // namespace

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
    case '&':
      escaped += "&amp;";
      break;
    case '<':
      escaped += "&lt;";
      break;
    case '>':
      escaped += "&gt;";
      break;
    case '"':
      escaped += "&quot;";
      break;
    case '\n': // as itself it would be read as a space
      escaped += "&#10;";
      break;
    default:
      escaped += static_cast<unsigned char>(c) < ' ' ? '_' : c;
    }
  }
  return escaped;
}

void Base64Encoder::append(std::span<const unsigned char> bytes, std::string& text) {
  while (pending_count_ > 0 && pending_count_ < 3 && !bytes.empty()) {
    pending_[pending_count_++] = bytes.front();
    bytes = bytes.subspan(1);
  }
  std::size_t end = text.size();
  text.resize(end + bytes.size() / 3 * 4 + 4);
  if (pending_count_ == 3) {
    put_three(pending_, text.data() + end);
    pending_count_ = 0;
    end += 4;
  }
  for (; bytes.size() >= 3; bytes = bytes.subspan(3), end += 4) put_three(bytes.data(), text.data() + end);
  text.resize(end);
  for (const unsigned char byte : bytes) pending_[pending_count_++] = byte;
}

void Base64Encoder::finish(std::string& text) {
  if (pending_count_ == 0) return;
  std::fill(pending_ + pending_count_, pending_ + 3, static_cast<unsigned char>(0));
  char digits[4];
  put_three(pending_, digits);
  std::fill(digits + pending_count_ + 1, digits + 4, '=');
  text.append(digits, 4);
  pending_count_ = 0;
}

// The next four digits, blanks left out, into decoded_.
bool Base64Decoder::decode_group(std::string_view& text) {
  unsigned values[4];
  int count = 0;
  while (count < 4 && !text.empty()) {
    const unsigned value = value_of(text.front());
    text.remove_prefix(1);
    if (value != blank) values[count++] = value;
  }
  if (count < 4 || values[0] >= 64 || values[1] >= 64) return false;
  if (values[2] > padding || values[3] > padding || (values[2] == padding && values[3] != padding))
    return false;
  begin_ = 0;
  end_ = values[2] == padding ? 1 : values[3] == padding ? 2 : 3;
  const unsigned bits = values[0] << 18 | values[1] << 12 | (values[2] & 63) << 6 | (values[3] & 63);
  for (std::size_t i = 0; i < 3; ++i) decoded_[i] = static_cast<unsigned char>(bits >> (16 - 8 * i));
  return true;
}

std::size_t Base64Decoder::decode(std::string_view& text, unsigned char* destination, std::size_t bytes) {
  std::size_t done = 0;
  while (done < bytes) {
    if (begin_ < end_) {
      destination[done++] = decoded_[begin_++];
      continue;
    }
    for (; bytes - done >= 3 && text.size() >= 4; text.remove_prefix(4), done += 3) { // plain digits only
      const unsigned a = value_of(text[0]), b = value_of(text[1]), c = value_of(text[2]),
                     d = value_of(text[3]);
      if ((a | b | c | d) >= 64) break;
      destination[done] = static_cast<unsigned char>(a << 2 | b >> 4);
      destination[done + 1] = static_cast<unsigned char>(b << 4 | c >> 2);
      destination[done + 2] = static_cast<unsigned char>(c << 6 | d);
    }
    if (done < bytes && !decode_group(text)) break;
  }
  return done;
}

CompressedArrayWriter::CompressedArrayWriter(AtomicFile& file, std::uint64_t bytes) : file_(file) {
  const std::uint64_t blocks = (bytes + block_bytes - 1) / block_bytes;
  header_ = {blocks, block_bytes, bytes % block_bytes};
  header_.reserve(3 + blocks);
  file_.leave_gap(((3 + blocks) * 8 + 2) / 3 * 4);
}

void CompressedArrayWriter::append(const void* data, std::size_t bytes) {
  const auto* next = static_cast<const unsigned char*>(data);
  while (bytes > 0) {
    const std::size_t part = std::min(bytes, block_bytes - block_.size());
    if (part == block_bytes) {
      compress_block(next, part);
    } else {
      block_.insert(block_.end(), next, next + part);
      if (block_.size() == block_bytes) {
        compress_block(block_.data(), block_.size());
        block_.clear();
      }
    }
    next += part;
    bytes -= part;
  }
}

void CompressedArrayWriter::compress_block(const unsigned char* block, std::size_t bytes) {
  if (file_.failed()) return;
  uLongf size = compressBound(bytes);
  compressed_.resize(size);
  if (compress2(compressed_.data(), &size, block, bytes, compression_level) != Z_OK) throw std::bad_alloc();
  header_.push_back(size);
  text_.clear();
  encoder_.append({compressed_.data(), size}, text_);
  file_.write(text_);
}

void CompressedArrayWriter::finish() {
  if (!block_.empty()) compress_block(block_.data(), block_.size());
  text_.clear();
  encoder_.finish(text_);
  file_.write(text_);
  assert(file_.failed() || header_.size() == 3 + header_[0]);
  file_.fill_gap(base64_of(header_));
}

} // namespace hyperiso

#include "mesh/exact_integer.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hyperiso {

namespace {

// An odd mantissa and an exponent.
struct Parts {
  std::uint64_t mantissa;
  int exponent;
};

Parts parts_of(double value) {
  int exponent = 0;
  auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::abs(std::frexp(value, &exponent)), 53));
  const int zeros = std::countr_zero(mantissa);
  return {mantissa >> zeros, exponent - 53 + zeros};
}

} // namespace

int lowest_bit(double value) { return parts_of(value).exponent; }

ExactInteger::ExactInteger(double value, int shift) : negative_(value < 0) {
  if (value == 0) return;
  const Parts parts = parts_of(value);
  const auto position = static_cast<unsigned>(parts.exponent + shift);
  limbs_.assign(position / 32 + 3, 0);
  const unsigned within = position % 32;
  const std::uint64_t low = parts.mantissa << within,
                      high = within == 0 ? 0 : parts.mantissa >> (64 - within);
  limbs_[position / 32] = static_cast<std::uint32_t>(low);
  limbs_[position / 32 + 1] = static_cast<std::uint32_t>(low >> 32);
  limbs_[position / 32 + 2] = static_cast<std::uint32_t>(high);
  drop_leading_zeros();
}

ExactInteger& ExactInteger::add(const ExactInteger& other, bool other_negative) {
  if (other.limbs_.empty()) return *this;
  if (limbs_.empty()) {
    limbs_ = other.limbs_;
    negative_ = other_negative;
    return *this;
  }
  if (negative_ == other_negative) {
    limbs_.resize(std::max(limbs_.size(), other.limbs_.size()) + 1);
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      carry += std::uint64_t{limbs_[i]} + (i < other.limbs_.size() ? other.limbs_[i] : 0);
      limbs_[i] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
  } else { // the smaller from the larger
    const bool other_larger = compare_sizes(*this, other) < 0;
    const std::vector<std::uint32_t> mine = limbs_;
    const std::vector<std::uint32_t>& larger = other_larger ? other.limbs_ : mine;
    const std::vector<std::uint32_t>& smaller = other_larger ? mine : other.limbs_;
    limbs_.resize(larger.size());
    std::int64_t borrow = 0;
    for (std::size_t i = 0; i < larger.size(); ++i) {
      borrow += std::int64_t{larger[i]} - (i < smaller.size() ? smaller[i] : 0);
      limbs_[i] = static_cast<std::uint32_t>(borrow);
      borrow >>= 32;
    }
    if (other_larger) negative_ = other_negative;
  }
  drop_leading_zeros();
  return *this;
}

ExactInteger operator*(const ExactInteger& a, const ExactInteger& b) {
  ExactInteger product;
  if (a.limbs_.empty() || b.limbs_.empty()) return product;
  product.limbs_.assign(a.limbs_.size() + b.limbs_.size(), 0);
  for (std::size_t i = 0; i < a.limbs_.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < b.limbs_.size(); ++j) {
      carry += std::uint64_t{a.limbs_[i]} * b.limbs_[j] + product.limbs_[i + j];
      product.limbs_[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    product.limbs_[i + b.limbs_.size()] = static_cast<std::uint32_t>(carry);
  }
  product.negative_ = a.negative_ != b.negative_;
  product.drop_leading_zeros();
  return product;
}

std::strong_ordering ExactInteger::compare_sizes(const ExactInteger& a, const ExactInteger& b) {
  if (a.limbs_.size() != b.limbs_.size()) return a.limbs_.size() <=> b.limbs_.size();
  return std::lexicographical_compare_three_way(a.limbs_.rbegin(), a.limbs_.rend(), b.limbs_.rbegin(),
                                                b.limbs_.rend());
}

void ExactInteger::drop_leading_zeros() {
  while (!limbs_.empty() && limbs_.back() == 0) limbs_.pop_back();
}

} // namespace hyperiso

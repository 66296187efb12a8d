// Structure-of-arrays blocks: R quantities (rows) for W independent lanes (columns); batch is the native shape everywhere.
#pragma once
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>

namespace sysid {

/// View of R rows of W lanes; row r is contiguous. Column w belongs to one particle, chain or draw.
template <class T>
class LaneView {
 public:
  LaneView() = default;
  LaneView(T* data, int rows, int width, int stride) : data_(data), rows_(rows), width_(width), stride_(stride) {}
  LaneView(T* data, int rows, int width) : LaneView(data, rows, width, width) {}
  operator LaneView<T const>() const { return {data_, rows_, width_, stride_}; }

  int rows() const { return rows_; }
  int width() const { return width_; }
  int stride() const { return stride_; }
  T* data() const { return data_; }
  T& operator()(int row, int lane) const { return data_[static_cast<std::ptrdiff_t>(row) * stride_ + lane]; }
  std::span<T> row(int r) const { return {data_ + static_cast<std::ptrdiff_t>(r) * stride_, static_cast<std::size_t>(width_)}; }
  /// Lanes [first, first + count) of the same rows.
  LaneView columns(int first, int count) const { return {data_ + first, rows_, count, stride_}; }

 private:
  T* data_ = nullptr;
  int rows_ = 0;
  int width_ = 0;
  int stride_ = 0;
};

using Lanes = LaneView<double>;
using ConstLanes = LaneView<double const>;

/// Owns an R x W block, rows aligned to 64 bytes when W is a multiple of 8; zero-initialised.
class LaneArray {
 public:
  LaneArray() = default;
  LaneArray(int rows, int width) : rows_(rows), width_(width) {
    if (rows < 0 || width < 0) throw std::bad_alloc();  // a count beyond the range of int
    std::size_t const bytes = (sizeof(double) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(width) + 63) / 64 * 64;
    data_.reset(static_cast<double*>(std::aligned_alloc(64, bytes == 0 ? 64 : bytes)));
    if (!data_) throw std::bad_alloc();
    for (std::size_t i = 0; i < static_cast<std::size_t>(rows) * static_cast<std::size_t>(width); ++i) data_.get()[i] = 0;
  }
  explicit LaneArray(ConstLanes other) : LaneArray(other.rows(), other.width()) {
    for (int r = 0; r < rows_; ++r)
      for (int w = 0; w < width_; ++w) view()(r, w) = other(r, w);
  }
  LaneArray(LaneArray const& other) : LaneArray(other.rows_, other.width_) { copy(other); }
  LaneArray(LaneArray&&) = default;
  LaneArray& operator=(LaneArray const& other) {
    if (this != &other) {
      if (rows_ != other.rows_ || width_ != other.width_) *this = LaneArray(other.rows_, other.width_);
      copy(other);
    }
    return *this;
  }
  LaneArray& operator=(LaneArray&&) = default;

  int rows() const { return rows_; }
  int width() const { return width_; }
  Lanes view() { return {data_.get(), rows_, width_}; }
  ConstLanes view() const { return {data_.get(), rows_, width_}; }
  operator Lanes() { return view(); }
  operator ConstLanes() const { return view(); }
  double& operator()(int row, int lane) { return view()(row, lane); }
  double operator()(int row, int lane) const { return view()(row, lane); }
  std::span<double> row(int r) { return view().row(r); }
  std::span<double const> row(int r) const { return view().row(r); }

 private:
  struct Free {
    void operator()(double* p) const { std::free(p); }
  };
  void copy(LaneArray const& other) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(rows_) * static_cast<std::size_t>(width_); ++i)
      data_.get()[i] = other.data_.get()[i];
  }
  int rows_ = 0;
  int width_ = 0;
  std::unique_ptr<double, Free> data_;
};

}  // namespace sysid

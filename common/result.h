#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "common/check.h"

namespace terray {

/// Why an operation that may fail in normal use did fail: a sentence for people.
struct Failure {
    std::string message;
};

/// The value of an operation, or why there is none. For what is expected at run time: missing tiles, bad bytes, lost
/// peers. Reading the value of a failure is misuse and stops the program.
template <class T>
class [[nodiscard]] Result {
  public:
    Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}  // NOLINT(google-explicit-constructor)
    Result(Failure failure)
        : content_(std::in_place_index<1>, std::move(failure)) {}  // NOLINT(google-explicit-constructor)

    [[nodiscard]] bool ok() const { return content_.index() == 0; }
    explicit operator bool() const { return ok(); }

    [[nodiscard]] T& value() & {
        TERRAY_CHECK(ok());
        return std::get<0>(content_);
    }
    [[nodiscard]] const T& value() const& {
        TERRAY_CHECK(ok());
        return std::get<0>(content_);
    }
    [[nodiscard]] T&& value() && {
        TERRAY_CHECK(ok());
        return std::get<0>(std::move(content_));
    }
    [[nodiscard]] T& operator*() & { return value(); }
    [[nodiscard]] const T& operator*() const& { return value(); }
    [[nodiscard]] T&& operator*() && { return std::move(*this).value(); }
    [[nodiscard]] T* operator->() { return &value(); }
    [[nodiscard]] const T* operator->() const { return &value(); }

    [[nodiscard]] const Failure& failure() const {
        TERRAY_CHECK(!ok());
        return std::get<1>(content_);
    }

  private:
    std::variant<T, Failure> content_;
};

/// Success without a value, or why not.
template <>
class [[nodiscard]] Result<void> {
  public:
    Result() = default;
    Result(Failure failure) : failure_(std::move(failure)) {}  // NOLINT(google-explicit-constructor)

    [[nodiscard]] bool ok() const { return !failure_; }
    explicit operator bool() const { return ok(); }
    [[nodiscard]] const Failure& failure() const {
        TERRAY_CHECK(!ok());
        return *failure_;
    }

  private:
    std::optional<Failure> failure_;
};

}  // namespace terray

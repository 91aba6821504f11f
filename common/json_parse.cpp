// The reading half of json.h.
#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

#include "common/json.h"

namespace terray {
namespace {

/// Arrays and objects within one another; a bound on the stack that a hostile text can use.
constexpr int kMaxDepth = 64;

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

/// Length of the well-formed UTF-8 sequence at the start of `text`, 0 when there is none (Unicode 15, table 3-7).
size_t utf8Length(std::string_view text) {
    const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0; };
    const auto continues = [&](size_t i, int low = 0x80, int high = 0xBF) { return byte(i) >= low && byte(i) <= high; };
    const int first = byte(0);
    if (first < 0x80) return 1;
    if (first >= 0xC2 && first <= 0xDF) return continues(1) ? 2 : 0;
    if (first >= 0xE0 && first <= 0xEF) {
        // E0 would be overlong below A0; ED from A0 on would be a surrogate.
        const bool second = continues(1, first == 0xE0 ? 0xA0 : 0x80, first == 0xED ? 0x9F : 0xBF);
        return second && continues(2) ? 3 : 0;
    }
    if (first >= 0xF0 && first <= 0xF4) {
        // F0 would be overlong below 90; F4 from 90 on would lie beyond U+10FFFF.
        const bool second = continues(1, first == 0xF0 ? 0x90 : 0x80, first == 0xF4 ? 0x8F : 0xBF);
        return second && continues(2) && continues(3) ? 4 : 0;
    }
    return 0;
}

void appendUtf8(std::string& text, uint32_t codePoint) {
    const auto put = [&](uint32_t byte) { text += static_cast<char>(byte); };
    if (codePoint < 0x80) {
        put(codePoint);
    } else if (codePoint < 0x800) {
        put(0xC0 | codePoint >> 6);
        put(0x80 | (codePoint & 0x3F));
    } else if (codePoint < 0x10000) {
        put(0xE0 | codePoint >> 12);
        put(0x80 | (codePoint >> 6 & 0x3F));
        put(0x80 | (codePoint & 0x3F));
    } else {
        put(0xF0 | codePoint >> 18);
        put(0x80 | (codePoint >> 12 & 0x3F));
        put(0x80 | (codePoint >> 6 & 0x3F));
        put(0x80 | (codePoint & 0x3F));
    }
}

/// Recursive descent over one text. Every function returns false after noting what is wrong, once, in `failure_`.
class Parser {
  public:
    explicit Parser(std::string_view text) : text_(text) {}

    Result<Json> parse() {
        Json value;
        if (!parseValue(value, 0)) return failure();
        skipSpace();
        if (position_ != text_.size()) {
            fail("expected the end of the text after the value");
            return failure();
        }
        return value;
    }

  private:
    bool parseValue(Json& value, int depth) {
        skipSpace();
        if (atEnd()) return fail("expected a value, found the end of the text");
        const char c = peek();
        if (c == '{') return parseObject(value, depth + 1);
        if (c == '[') return parseArray(value, depth + 1);
        if (c == '"') {
            std::string string;
            if (!parseString(string)) return false;
            value = Json(std::move(string));
            return true;
        }
        if (c == '-' || isDigit(c)) return parseNumber(value);
        if (takeWord("true")) return assign(value, Json(true));
        if (takeWord("false")) return assign(value, Json(false));
        if (takeWord("null")) return assign(value, Json());
        return fail("expected a value");
    }

    bool parseObject(Json& value, int depth) {
        if (depth > kMaxDepth) return fail("nested deeper than " + std::to_string(kMaxDepth) + " levels");
        take('{');
        Json::Object object;
        std::set<std::string> names;
        skipSpace();
        if (take('}')) return assign(value, Json(std::move(object)));
        for (;;) {
            skipSpace();
            const size_t start = position_;
            std::string name;
            if (atEnd() || peek() != '"') return fail("expected a member name in quotes");
            if (!parseString(name)) return false;
            if (!names.insert(name).second) {
                position_ = start;
                return fail("the name \"" + name + "\" occurs twice in one object");
            }
            skipSpace();
            if (!take(':')) return fail("expected ':' after a member name");
            Json item;
            if (!parseValue(item, depth)) return false;
            object.emplace_back(std::move(name), std::move(item));
            skipSpace();
            if (take('}')) return assign(value, Json(std::move(object)));
            if (!take(',')) return fail("expected ',' or '}' after a member");
        }
    }

    bool parseArray(Json& value, int depth) {
        if (depth > kMaxDepth) return fail("nested deeper than " + std::to_string(kMaxDepth) + " levels");
        take('[');
        Json::Array array;
        skipSpace();
        if (take(']')) return assign(value, Json(std::move(array)));
        for (;;) {
            Json item;
            if (!parseValue(item, depth)) return false;
            array.push_back(std::move(item));
            skipSpace();
            if (take(']')) return assign(value, Json(std::move(array)));
            if (!take(',')) return fail("expected ',' or ']' after an element");
        }
    }

    bool parseString(std::string& string) {
        take('"');
        while (!atEnd()) {
            const char c = peek();
            if (take('"')) return true;
            if (static_cast<unsigned char>(c) < 0x20) return fail("a control character in a string must be escaped");
            if (c == '\\') {
                if (!parseEscape(string)) return false;
                continue;
            }
            const size_t length = utf8Length(text_.substr(position_));
            if (length == 0) return fail("a string is not valid UTF-8");
            string += text_.substr(position_, length);
            position_ += length;
        }
        return fail("a string does not end");
    }

    bool parseEscape(std::string& string) {
        constexpr std::string_view kEscapes = "\"\\/bfnrt";
        constexpr std::string_view kMeanings = "\"\\/\b\f\n\r\t";
        if (position_ + 1 >= text_.size()) return fail("a string does not end");
        const char c = text_[position_ + 1];
        if (c == 'u') return parseUnicodeEscape(string);
        const size_t index = kEscapes.find(c);
        if (index == std::string_view::npos) return fail("unknown escape in a string");
        string += kMeanings[index];
        position_ += 2;
        return true;
    }

    /// \uXXXX, or two of them that form a surrogate pair.
    bool parseUnicodeEscape(std::string& string) {
        const auto first = hexQuad();
        if (!first) return fail("expected four hexadecimal digits after \\u");
        if (*first >= 0xDC00 && *first <= 0xDFFF) return fail("a low surrogate without a high one before it");
        if (*first < 0xD800 || *first > 0xDBFF) {
            appendUtf8(string, *first);
            position_ += 6;
            return true;
        }
        position_ += 6;
        const auto second = hexQuad();
        if (!second || *second < 0xDC00 || *second > 0xDFFF) {
            position_ -= 6;
            return fail("a high surrogate without a low one after it");
        }
        appendUtf8(string, 0x10000 + ((*first - 0xD800) << 10) + (*second - 0xDC00));
        position_ += 6;
        return true;
    }

    /// The number of a \uXXXX at the current position, which stays where it is.
    [[nodiscard]] std::optional<uint32_t> hexQuad() const {
        const std::string_view escape = text_.substr(std::min(position_, text_.size()), 6);
        if (escape.size() != 6 || !escape.starts_with("\\u")) return {};
        uint32_t number = 0;
        const auto result = std::from_chars(escape.data() + 2, escape.data() + 6, number, 16);
        if (result.ec != std::errc() || result.ptr != escape.data() + 6) return {};
        return number;
    }

    /// The grammar is stricter than from_chars: no leading zeros, digits on both sides of the point.
    bool parseNumber(Json& value) {
        const size_t start = position_;
        take('-');
        if (!take('0') && !takeDigits()) return failAt(start, "expected digits in a number");
        if (take('.') && !takeDigits()) return failAt(start, "expected digits after the point of a number");
        if (take('e') || take('E')) {
            if (!take('+')) take('-');
            if (!takeDigits()) return failAt(start, "expected digits in the exponent of a number");
        }
        double number = 0;
        const auto result = std::from_chars(text_.data() + start, text_.data() + position_, number);
        if (result.ec == std::errc::result_out_of_range) return failAt(start, "a number is out of a double's range");
        return assign(value, Json(number));
    }

    [[nodiscard]] bool atEnd() const { return position_ >= text_.size(); }
    [[nodiscard]] char peek() const { return text_[position_]; }
    bool take(char c) {
        if (atEnd() || peek() != c) return false;
        ++position_;
        return true;
    }
    bool takeDigits() {
        const size_t start = position_;
        while (!atEnd() && isDigit(peek())) ++position_;
        return position_ > start;
    }
    bool takeWord(std::string_view word) {
        if (!text_.substr(position_).starts_with(word)) return false;
        position_ += word.size();
        return true;
    }
    void skipSpace() {
        while (!atEnd() && (peek() == ' ' || peek() == '\t' || peek() == '\n' || peek() == '\r')) ++position_;
    }
    static bool assign(Json& value, Json parsed) {
        value = std::move(parsed);
        return true;
    }

    bool fail(std::string what) {
        failure_ = std::move(what);
        return false;
    }
    bool failAt(size_t position, std::string what) {
        position_ = position;
        return fail(std::move(what));
    }
    /// What was noted, with line and column (both from 1, columns in bytes) of the current position.
    [[nodiscard]] Failure failure() const {
        const std::string_view before = text_.substr(0, position_);
        const auto line = 1 + std::count(before.begin(), before.end(), '\n');
        const size_t lineStart = before.rfind('\n') + 1;  // npos + 1 is 0: the first line
        return {"JSON line " + std::to_string(line) + ", column " + std::to_string(position_ - lineStart + 1) + ": " +
                failure_};
    }

    std::string_view text_;
    size_t position_ = 0;
    std::string failure_;
};

}  // namespace

Result<Json> Json::parse(std::string_view text) {
    return Parser(text).parse();
}

}  // namespace terray

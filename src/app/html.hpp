#pragma once

#include <string>
#include <string_view>

namespace meltscope {

/// Text as it may stand in HTML, between tags and in quoted attributes; bytes that are not UTF-8 and control
/// characters become U+FFFD.
std::string escape_html(std::string_view text);

/// Base64 (RFC 4648, section 4) without line breaks.
std::string base64(std::string_view bytes);

/// A data URL (RFC 2397) that carries the bytes: how a page holds its pictures and movies itself.
std::string data_url(std::string_view media_type, std::string_view bytes);

} // namespace meltscope

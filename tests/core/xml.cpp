// Escapes of XML.
#include "core/text/xml.hpp"

#include <doctest/doctest.h>

TEST_CASE("text in XML keeps its bytes but for the four characters that mean something there") {
  CHECK(sysid::escape("a < b && \"c\" > d") == "a &lt; b &amp;&amp; &quot;c&quot; &gt; d");
  CHECK(sysid::escape("µm, l'été") == "µm, l'été");
}

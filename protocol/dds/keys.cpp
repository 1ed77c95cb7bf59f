#include "protocol/dds/keys.hpp"

#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/kdf.h>
#include <openssl/params.h>
#include <sys/random.h>

#include "common/error.hpp"

namespace tandem::protocol::dds {
namespace {

void expect_done(bool done, const char* deed) {
  if (!done) throw Error(ErrorCode::resource, std::string("OpenSSL cannot ") + deed, "dds");
}

EVP_MAC_CTX* mac(void* context) {
  return static_cast<EVP_MAC_CTX*>(context);
}

char sha256[] = "SHA256";  // OpenSSL requires non-const text

}  // namespace

Nonce fresh_nonce() {
  Nonce nonce{};
  expect_done(getrandom(nonce.data(), nonce.size(), 0) == static_cast<ssize_t>(nonce.size()),
              "have random numbers from the system");
  return nonce;
}

Key derive_key(std::string_view secret, std::span<const std::uint8_t> salt, std::string_view info) {
  const std::unique_ptr<EVP_KDF, decltype(&EVP_KDF_free)> hkdf(EVP_KDF_fetch(nullptr, "HKDF", nullptr),
                                                               EVP_KDF_free);
  expect_done(hkdf != nullptr, "derive keys");
  const std::unique_ptr<EVP_KDF_CTX, decltype(&EVP_KDF_CTX_free)> context(EVP_KDF_CTX_new(hkdf.get()),
                                                                          EVP_KDF_CTX_free);
  // RFC 5869: without a salt it is zeros.
  const Key no_salt{};
  if (salt.empty()) salt = no_salt;
  const auto octets = [](const char* name, const void* data, std::size_t size) {
    return OSSL_PARAM_construct_octet_string(name, const_cast<void*>(data), size);
  };
  const OSSL_PARAM parameters[] = {OSSL_PARAM_construct_utf8_string(OSSL_KDF_PARAM_DIGEST, sha256, 0),
                                   octets(OSSL_KDF_PARAM_KEY, secret.data(), secret.size()),
                                   octets(OSSL_KDF_PARAM_SALT, salt.data(), salt.size()),
                                   octets(OSSL_KDF_PARAM_INFO, info.data(), info.size()),
                                   OSSL_PARAM_construct_end()};
  Key key{};
  expect_done(context != nullptr && EVP_KDF_derive(context.get(), key.data(), key.size(), parameters) == 1,
              "derive keys");
  return key;
}

bool equal(const Tag& a, const Tag& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

void Authenticator::Free::operator()(void* context) const {
  EVP_MAC_CTX_free(mac(context));
}

Authenticator::Authenticator(const Key& key) {
  const std::unique_ptr<EVP_MAC, decltype(&EVP_MAC_free)> hmac(EVP_MAC_fetch(nullptr, "HMAC", nullptr),
                                                               EVP_MAC_free);
  expect_done(hmac != nullptr, "authenticate messages");
  context_.reset(EVP_MAC_CTX_new(hmac.get()));
  const OSSL_PARAM parameters[] = {OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_DIGEST, sha256, 0),
                                   OSSL_PARAM_construct_end()};
  expect_done(context_ && EVP_MAC_init(mac(context_.get()), key.data(), key.size(), parameters) == 1,
              "authenticate messages");
}

void Authenticator::begin() {
  expect_done(EVP_MAC_init(mac(context_.get()), nullptr, 0, nullptr) == 1, "begin a message");
}

void Authenticator::add(const void* data, std::size_t size) {
  expect_done(EVP_MAC_update(mac(context_.get()), static_cast<const unsigned char*>(data), size) == 1,
              "authenticate a message");
}

Tag Authenticator::finish() {
  Tag tag{};
  std::size_t size = 0;
  expect_done(EVP_MAC_final(mac(context_.get()), tag.data(), &size, tag.size()) == 1 && size == tag.size(),
              "authenticate a message");
  return tag;
}

}  // namespace tandem::protocol::dds

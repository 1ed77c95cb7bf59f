// X.509 certificates and S/MIME signatures of the DDS Security standard [DdsSecurity], by OpenSSL.
#include <fmt/format.h>
#include <openssl/ec.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509v3.h>

#include <chrono>
#include <memory>

#include "common/error.hpp"
#include "launch/keys/keys.hpp"
#include "launch/keys/private_file.hpp"
#include "protocol/dds/certificates.hpp"
#include "protocol/secret.hpp"

namespace tandem::launch {
namespace {

namespace names = protocol::certificate_files;

template <class T, void (*free)(T*)>
struct Freed {
  void operator()(T* thing) const { free(thing); }
};
using PrivateKey = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY, EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509, X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION, X509_EXTENSION_free>>;
using Signed = std::unique_ptr<PKCS7, Freed<PKCS7, PKCS7_free>>;
using Memory = std::unique_ptr<BIO, Freed<BIO, BIO_free_all>>;

void expect_made(bool done, const char* what) {
  if (!done) throw Error(ErrorCode::resource, std::string("OpenSSL cannot make ") + what, "keys");
}

Memory memory(const std::string& text = {}) {
  Memory made(text.empty() ? BIO_new(BIO_s_mem())
                           : BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  expect_made(made != nullptr, "room");
  return made;
}

std::string text_in(const Memory& memory) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

PrivateKey new_key() {
  PrivateKey key(EVP_EC_gen("P-256"));
  expect_made(key != nullptr, "a key");
  return key;
}

void extend(X509* certificate, X509* issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value));
  expect_made(extension && X509_add_ext(certificate, extension.get(), -1) == 1, "an extension");
}

// Signed by `issuer`; self-signed where that is null, which makes it an authority.
Certificate new_certificate(const std::string& name, EVP_PKEY* key, X509* issuer, EVP_PKEY* issuer_key,
                            int days) {
  Certificate made(X509_new());
  X509* x = made.get();
  const std::string serial = protocol::make_secret().substr(0, 30);
  BIGNUM* number = nullptr;
  X509_NAME* subject = x != nullptr ? X509_get_subject_name(x) : nullptr;
  const bool filled =
      subject != nullptr && X509_set_version(x, X509_VERSION_3) == 1 &&
      BN_hex2bn(&number, serial.c_str()) > 0 &&
      BN_to_ASN1_INTEGER(number, X509_get_serialNumber(x)) != nullptr &&
      // allows for different clocks of two hosts
      X509_gmtime_adj(X509_getm_notBefore(x), -3600) != nullptr &&
      X509_gmtime_adj(X509_getm_notAfter(x), 86400L * days) != nullptr && X509_set_pubkey(x, key) == 1 &&
      X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8,
                                 reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1, 0) == 1 &&
      X509_set_issuer_name(x, issuer != nullptr ? X509_get_subject_name(issuer) : subject) == 1;
  BN_free(number);
  expect_made(filled, "a certificate");
  extend(x, issuer != nullptr ? issuer : x, NID_basic_constraints,
         issuer != nullptr ? "critical,CA:FALSE" : "critical,CA:TRUE");
  extend(
      x, issuer != nullptr ? issuer : x, NID_key_usage,
      issuer != nullptr ? "critical,digitalSignature,keyAgreement" : "critical,keyCertSign,digitalSignature");
  expect_made(X509_sign(x, issuer_key, EVP_sha256()) > 0, "a signature");
  return made;
}

std::string pem_of(X509* certificate) {
  const Memory out = memory();
  expect_made(PEM_write_bio_X509(out.get(), certificate) == 1, "a certificate");
  return text_in(out);
}

std::string pem_of(EVP_PKEY* key) {
  const Memory out = memory();
  expect_made(PEM_write_bio_PrivateKey(out.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1, "a key");
  return text_in(out);
}

// As `openssl smime -sign -text` does.
std::string signed_text(const std::string& text, X509* signer, EVP_PKEY* key) {
  constexpr int flags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM;
  const Memory in = memory(text), out = memory();
  const Signed made(PKCS7_sign(signer, key, nullptr, in.get(), flags));
  expect_made(made && SMIME_write_PKCS7(out.get(), made.get(), in.get(), flags) == 1, "a signature");
  return text_in(out);
}

constexpr const char* head_of_rules = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-Security/20170801/omg_shared_ca_{}.xsd">
)";

// Every message is encrypted as a whole, so that its parts need no encryption of their own.
std::string governance() {
  return fmt::format(fmt::runtime(head_of_rules), "governance") + R"(<domain_access_rules><domain_rule>
<domains><id_range><min>0</min><max>230</max></id_range></domains>
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>ENCRYPT</rtps_protection_kind>
<topic_access_rules><topic_rule>
<topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>NONE</metadata_protection_kind>
<data_protection_kind>NONE</data_protection_kind>
</topic_rule></topic_access_rules>
</domain_rule></domain_access_rules></dds>
)";
}

std::string permissions(const std::string& subject, int days) {
  using namespace std::chrono;
  const auto day = floor<std::chrono::days>(system_clock::now());
  const auto text = [](sys_days at) {
    const year_month_day date(at);
    return fmt::format("{:04}-{:02}-{:02}T00:00:00Z", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
  };
  return fmt::format(fmt::runtime(head_of_rules), "permissions") +
         fmt::format(R"(<permissions><grant name="tandem">
<subject_name>CN={}</subject_name>
<validity><not_before>{}</not_before><not_after>{}</not_after></validity>
<allow_rule><domains><id_range><min>0</min><max>230</max></id_range></domains>
<publish><topics><topic>tandem_*</topic></topics></publish>
<subscribe><topics><topic>tandem_*</topic></topics></subscribe>
</allow_rule>
<default>DENY</default>
</grant></permissions></dds>
)",
                     subject, text(day - std::chrono::days(1)), text(day + std::chrono::days(days)));
}

}  // namespace

void write_certificates(const std::filesystem::path& folder, int days) {
  std::error_code failure;
  if (std::filesystem::exists(folder, failure) && !std::filesystem::is_empty(folder, failure))
    throw Error(ErrorCode::usage, "holds something already", folder.string(), "give a new folder");
  std::filesystem::create_directories(folder, failure);
  if (!failure) std::filesystem::permissions(folder, std::filesystem::perms::owner_all, failure);
  if (failure)
    throw Error(ErrorCode::resource, "cannot be made: " + failure.message(), folder.string(),
                "give another folder");

  const std::string mark = protocol::make_secret().substr(0, 16), subject = "tandem-" + mark;
  const PrivateKey authority_key = new_key(), key = new_key();
  const Certificate authority =
      new_certificate("tandem-authority-" + mark, authority_key.get(), nullptr, authority_key.get(), days);
  const Certificate identity =
      new_certificate(subject, key.get(), authority.get(), authority_key.get(), days);
  write_private_file(folder / names::authority, pem_of(authority.get()));
  write_private_file(folder / names::identity, pem_of(identity.get()));
  write_private_file(folder / names::key, pem_of(key.get()));
  write_private_file(folder / names::governance,
                     signed_text(governance(), authority.get(), authority_key.get()));
  write_private_file(folder / names::permissions,
                     signed_text(permissions(subject, days), authority.get(), authority_key.get()));
}

}  // namespace tandem::launch

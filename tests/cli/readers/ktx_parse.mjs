// KTX2 files as npm's ktx-parse reads them: node ktx_parse.mjs FOLDER_OF_PACKAGE FILE...; JSON, an object a file.
import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [folder, ...files] = process.argv.slice(2);
const { exports } = JSON.parse(fs.readFileSync(path.join(folder, "package.json"), "utf8"));
const { read } = await import(pathToFileURL(path.resolve(folder, exports["."].default)));

const described = files.map((file) => {
  const texture = read(new Uint8Array(fs.readFileSync(file)));
  const descriptor = texture.dataFormatDescriptor[0];
  return {
    vkFormat: texture.vkFormat,
    typeSize: texture.typeSize,
    size: [texture.pixelWidth, texture.pixelHeight],
    scheme: texture.supercompressionScheme,
    model: descriptor.colorModel,
    transfer: descriptor.transferFunction,
    samples: descriptor.samples.length,
    writer: texture.keyValue.KTXwriter,
    levels: texture.levels.map((level) => ({
      stored: Buffer.from(level.levelData).toString("hex"),
      bytes: level.uncompressedByteLength,
    })),
  };
});
console.log(JSON.stringify(described));

// glTF files as Khronos's validator finds them: node gltf_validator.mjs FOLDER_OF_PACKAGE FILE...; JSON, a list of issues a file.
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [folder, ...files] = process.argv.slice(2);
const validator = createRequire(import.meta.url)(path.resolve(folder));

const found = [];
for (const file of files) {
  const beside = (uri) => fs.promises.readFile(path.join(path.dirname(file), decodeURIComponent(uri)));
  const bytes = new Uint8Array(fs.readFileSync(file));
  const report = await validator.validateBytes(bytes, { uri: file, externalResourceFunction: beside });
  found.push(report.issues.messages);
}
console.log(JSON.stringify(found));

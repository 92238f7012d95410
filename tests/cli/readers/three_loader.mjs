// Materials as three.js loads them, by GLTFLoader with KTX2Loader: node three_loader.mjs FOLDER_OF_PACKAGE FILE...; JSON, a list of
// materials a file, with width, height and bytes of every mip of their textures.
import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [folder, ...files] = process.argv.slice(2);
const load = (name) => import(pathToFileURL(path.resolve(folder, "examples/jsm/loaders", name)));
// What a browser has.
globalThis.self = globalThis;
globalThis.ProgressEvent ??= class extends Event {};
const { GLTFLoader } = await load("GLTFLoader.js");
const { KTX2Loader } = await load("KTX2Loader.js");

const mips = (texture) => texture && texture.mipmaps.map((mip) => [mip.width, mip.height, mip.data.length]);
const found = [];
for (const file of files) {
  const ktx2 = new KTX2Loader();
  // A renderer would say which compressed formats it has; ours needs none.
  ktx2.workerConfig = {};
  const loader = new GLTFLoader().setKTX2Loader(ktx2);
  const bytes = new Uint8Array(fs.readFileSync(file));
  const { parser } = await loader.parseAsync(bytes.buffer, path.resolve(path.dirname(file)) + "/");
  const materials = await parser.getDependencies("material");
  found.push(
    materials.map((material) => ({
      normal: mips(material.normalMap),
      roughness: mips(material.roughnessMap),
      occlusion: mips(material.aoMap),
      factor: material.roughness,
      scale: material.normalScale?.x,
    })),
  );
}
console.log(JSON.stringify(found));
